"""Other people's measurements, each diagnosed by one command and held against what is known of it."""
