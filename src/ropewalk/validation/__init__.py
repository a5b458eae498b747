"""What is known from books, standards and other programs, computed and compared: `ropewalk validate`."""
