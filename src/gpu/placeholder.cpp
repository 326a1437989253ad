namespace tarn { int room_gpu; }
