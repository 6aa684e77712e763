"""``python -m svgf_cl`` is ``svgf-cl``."""

from svgf_cl.cli import main

if __name__ == "__main__":
    main()
