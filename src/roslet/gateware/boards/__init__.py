"""What a design is built for: chips and boards, and the tools that do it."""
