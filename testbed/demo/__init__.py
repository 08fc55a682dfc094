"""The rig and the records that ship with the project, and the command that makes them."""
