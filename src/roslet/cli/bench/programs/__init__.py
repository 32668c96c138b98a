"""What other interpreters run for `roslet bench`: nothing here is imported by roslet."""
