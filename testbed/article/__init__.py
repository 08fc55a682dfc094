"""The article's case study, as a virtual experiment."""
