"""The tracer's own commands of ``svgf-cl``: one file a command. Importing them takes nothing that the tracer needs."""
