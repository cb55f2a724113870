"""Files of users, read and written: cases, matrices, results."""
