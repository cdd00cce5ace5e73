"""`python -m harness`: the program, which is `rockingcan.py` beside this package."""

from rockingcan import main

if __name__ == "__main__":
    main()
