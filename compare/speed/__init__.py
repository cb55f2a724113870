"""What a chart costs, against what other methods need for the same numbers."""
