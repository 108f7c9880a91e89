"""Contacts of blocks with the slope: from velocities before to velocities after."""
