"""The case files that come with the package: the figures of the paper."""
