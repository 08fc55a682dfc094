"""The page of effects: for every kind of the library its words, its signature and a picture of what it does."""
