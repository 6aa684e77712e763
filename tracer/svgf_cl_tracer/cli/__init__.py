"""The tracer's own commands of ``svgf-cl``, one file each. Importing them imports none of the tracer's dependencies."""
