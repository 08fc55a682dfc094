"""The next experiment: which affordable test separates what the records so far cannot tell apart."""
