"""The study of contact laws: what restitution is set, and what comes of it in a ball and in a beam."""
