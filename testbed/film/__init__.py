"""The moving rig: a stretch of a test as an animated picture and as a model that turns in a glTF viewer."""
