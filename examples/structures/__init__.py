"""Structures: columns and plates under loads that pulsate, chains, dampers."""
