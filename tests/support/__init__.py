"""What several files of tests share; `tests/conftest.py` holds the fixtures made of it."""
