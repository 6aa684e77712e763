"""What the project does to itself: pages that are made, checks, the documentation site, packages."""
