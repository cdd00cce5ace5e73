"""What engines that step a world share: schedule, settling, recording, horizon."""
