"""Plots of finished results: each takes an axes and values and computes nothing; ``sets`` draws them to files."""
