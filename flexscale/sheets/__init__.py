"""Sheets of a law: bent between strips, clamped, pushed, hinged; whatever the law is of."""
