"""The filters, one file each, and the words in which they are declared."""
