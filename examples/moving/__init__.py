"""Moving media: strings, belts, webs, pipes with flow."""
