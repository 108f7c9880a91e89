"""Files and tables: names and units of quantities, reading, writing, keeping."""
