namespace tarn { int room_image; }
