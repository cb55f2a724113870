"""Rotors: shafts, propellers, helicopters, gears."""
