"""Where loads touch lines and nets, what acts there, and where contacts go."""
