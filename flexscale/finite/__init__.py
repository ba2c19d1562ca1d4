"""Whole sheets, strips and discs of rigid scales on joints."""
