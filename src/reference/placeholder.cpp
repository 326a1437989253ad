namespace tarn { int room_reference; }
