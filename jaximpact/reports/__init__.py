"""What results are reported with: tables, trees for JSON, and documents, printed or as
one page."""
