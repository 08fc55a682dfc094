"""From a file to a ``models.record`` value resolved against a rig, and back: see ``read`` and ``write``."""
