// Counts rays. Whole numbers are exact in half floats.
layout(location = 0) out float out_count;

void main() { out_count = 1.0; }
