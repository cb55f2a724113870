"""Oscillators: pendulums, traps, resonators, a ship."""
