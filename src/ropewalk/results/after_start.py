AFTER_START = "after_start"
