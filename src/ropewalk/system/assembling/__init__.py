"""From a scenario to a structure and to what it carries."""
