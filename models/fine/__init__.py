"""A finer, independent discretisation that plays the rig in virtual tests: finite elements and Gauss collocation."""

from models.fine.response import FineSettings, fine_response

__all__ = ["FineSettings", "fine_response"]
