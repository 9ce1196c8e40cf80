"""``python -m visint``: the program, where the script is not on the path."""

from visint.cli.main import main

if __name__ == "__main__":
    main()
