"""Builds the documentation site with Sphinx, from pages of the repository and pages made from the code."""
