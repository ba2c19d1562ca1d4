"""Sheets, strips and stages of the scales themselves: the native model without a period."""
