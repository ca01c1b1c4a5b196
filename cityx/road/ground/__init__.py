"""The ground off the carriageways: blocks, yards, beds, pavements."""
