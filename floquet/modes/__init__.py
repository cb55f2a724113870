from floquet.modes.modes import FloquetMode, FloquetModes, floquet_modes

__all__ = ["FloquetMode", "FloquetModes", "floquet_modes"]
