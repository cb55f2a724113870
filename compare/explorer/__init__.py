"""Any system in any window: pictures, a page to click in, live or in a file, and sweeps of a parameter."""
