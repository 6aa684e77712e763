"""How far pictures are from their references."""
