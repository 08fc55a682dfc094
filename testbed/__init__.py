"""What a person touches: records, commands, reports and the browser application."""

__version__ = "0.1.0"
