"""What a person touches: records, commands and reports."""

__version__ = "0.2.0"
