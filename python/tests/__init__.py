"""Tests of the module, against the command and against what it says of itself."""
